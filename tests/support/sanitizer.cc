/// Compiled into the unit tests of a sanitizer build.
/// HDF5 1.10 leaks what it had read when it refuses a damaged file, which the tests of damaged packs make it do.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\n"; }
