#pragma once

#include <Python.h>
#include <cxxabi.h>
#include <unistd.h>

namespace poise::python {

/// Before the lock of the interpreter is taken. A daemon thread that comes when the interpreter ends would be ended by
/// it in the midst of C++, which ends the process with an abort; it waits for the end of the process instead.
inline void wait_where_python_ends() {
  while (_Py_IsFinalizing() != 0) ::pause();
}

/// While it lives this thread does not hold the lock of the interpreter.
class WithoutLock {
 public:
  WithoutLock() : ends_python_(_Py_IsFinalizing() != 0), state_(PyEval_SaveThread()) {}
  ~WithoutLock() {
    if (!ends_python_) wait_where_python_ends();
    try {
      PyEval_RestoreThread(state_);
    } catch (const abi::__forced_unwind&) {  // the interpreter began to end while this thread waited for its lock
      for (;;) ::pause();
    }
  }
  WithoutLock(const WithoutLock&) = delete;
  WithoutLock& operator=(const WithoutLock&) = delete;

 private:
  bool ends_python_;  ///< only the thread that ends the interpreter has the lock while it ends
  PyThreadState* state_;
};

}  // namespace poise::python
