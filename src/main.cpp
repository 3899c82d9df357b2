#include <cstdio>
int main() { std::puts("vitrum"); }
