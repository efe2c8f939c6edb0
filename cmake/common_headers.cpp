// Empty: CMake precompiles headers for targets that have a source only.
