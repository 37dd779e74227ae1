// Compiled with -DHEADER=<...> as if it belonged to a room: see CMakeLists.txt.
#include HEADER

int main() { return 0; }
