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
  /// CasADi under that one. What acquire() returns goes to release().
  struct Means {
    int (*acquire)();
    void (*release)(int);
  };
  /// Is called before the first thread begins.
  static void use(Means means);

 private:
  int token_;
};

}  // namespace saltus
