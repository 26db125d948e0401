#include <cstdio>

#include <kairos/error.h>
#include <kairos/mesh.h>
#include <kairos/scene.h>
#include <kairos/tracer.h>
#include <kairos/vec.h>
#include <kairos/version.h>

int main() { std::printf("kairos %s\n", kairos::version()); }
