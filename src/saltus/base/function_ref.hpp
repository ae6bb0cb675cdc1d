// A non-owning reference to a callable: one indirect call, no allocation. Outlives nothing: pass it down, never store
// it.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

namespace saltus {

template <class Signature>
class FunctionRef;

template <class R, class... Args>
class FunctionRef<R(Args...)> {
 public:
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<R, F&, Args...>) FunctionRef(
      F&& callable)  // NOLINT(google-explicit-constructor): lambdas convert at the call site
                     // reinterpret_cast, since static_cast does not take pointers to plain functions to void* and back.
      : object_(const_cast<void*>(reinterpret_cast<const volatile void*>(std::addressof(callable)))),
        call_([](void* object, Args... args) -> R {
          return (*reinterpret_cast<std::remove_reference_t<F>*>(object))(std::forward<Args>(args)...);
        }) {}

  R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

 private:
  void* object_;
  R (*call_)(void*, Args...);
};

}  // namespace saltus
