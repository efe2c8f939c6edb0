#pragma once

#include <Python.h>
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
  WithoutLock() : state_(PyEval_SaveThread()) {}
  ~WithoutLock() {
    wait_where_python_ends();
    PyEval_RestoreThread(state_);
  }
  WithoutLock(const WithoutLock&) = delete;
  WithoutLock& operator=(const WithoutLock&) = delete;

 private:
  PyThreadState* state_;
};

}  // namespace poise::python
