// One thread at a time makes, copies and drops symbolic expressions.
#pragma once

namespace saltus {

/// Is held while CasADi's expressions are made, copied or dropped: the counts of their nodes are not atomic, and nodes
/// of small numbers are shared by all expressions of a process. May be taken again by the thread that has it.
/// Evaluating compiled functions needs no lock. model::build and model::Builder do not take it: a program that builds
/// in several threads does so itself; pipeline::simulate takes it where it must.
class SymbolicLock {
 public:
  SymbolicLock();
  ~SymbolicLock();
  SymbolicLock(const SymbolicLock&) = delete;
  SymbolicLock& operator=(const SymbolicLock&) = delete;

  /// Says what to take instead of a mutex of this process: an interpreter's lock, for a program whose other parts use
  /// CasADi under that one. What acquire() returns goes to release(). let_go() gives up what this thread has acquired
  /// `times` times; what it returns goes to take_back().
  struct Means {
    int (*acquire)();
    void (*release)(int);
    void* (*let_go)(int times);
    void (*take_back)(void*, int times);
  };
  /// Is called before the first thread begins.
  static void use(Means means);

 private:
  int token_;
};

/// Lets go of this thread's SymbolicLock while compiled functions are only evaluated, and takes it back at its end.
/// A SymbolicLock may be taken meanwhile.
class SymbolicPause {
 public:
  SymbolicPause();
  ~SymbolicPause();
  SymbolicPause(const SymbolicPause&) = delete;
  SymbolicPause& operator=(const SymbolicPause&) = delete;

 private:
  int times_;
  void* token_ = nullptr;
};

}  // namespace saltus
