// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "load_checks.h"

#include "error.h"
#include "library.h"
#include "lmptype.h"

#include <dlfcn.h>
#include <link.h>
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

// Mark by which two copies of the plugin find each other.
extern "C" __attribute__((visibility("default"))) const int amberfield_lammps_plugin = 1;

// What the plugin takes from LAMMPS and MPI is weak, see the build: so it loads beside others too, and can
// say what is wrong.
namespace {

// LAMMPS' version that the headers belong to; the build gives it.
constexpr int COMPILED_FOR = AMBERFIELD_LAMMPS_VERSION;

#ifdef OPEN_MPI
constexpr const char *OWN_MPI = "Open MPI";
const std::vector<std::string> SAME_MPI = {"Open MPI"};
#else
constexpr const char *OWN_MPI = "MPICH";
// Programs of MPICH's ABI initiative.
const std::vector<std::string> SAME_MPI = {"MPICH", "MVAPICH", "Intel(R) MPI", "CRAY MPICH"};
#endif

// What is wrong with the MPI that the process has; empty if nothing is.
std::string wrong_mpi()
{
    using Version = int (*)(char *, int *);
    auto version = reinterpret_cast<Version>(dlsym(RTLD_DEFAULT, "MPI_Get_library_version"));
    std::string found = "no MPI that a plugin can reach";
    if (version) {
        char text[MPI_MAX_LIBRARY_VERSION_STRING + 1] = {0};
        int length = 0;
        version(text, &length);
        found = std::string(text).substr(0, std::string(text).find('\n'));
        for (const std::string &name : SAME_MPI) {
            if (found.find(name) != std::string::npos) return "";
        }
    }
    return "it was built for " + std::string(OWN_MPI) + ", but LAMMPS runs with " + found
        + "; build it against the mpi.h of LAMMPS' own MPI";
}

std::string wrong_version(int version)
{
    if (version != COMPILED_FOR) {
        return "it was built for LAMMPS " + std::to_string(COMPILED_FOR) + ", but this is LAMMPS "
            + std::to_string(version) + "; build it against this one's headers";
    }
    return "";
}

std::string wrong_widths(LAMMPS_NS::LAMMPS *lmp)
{
    struct Width {
        const char *name;
        size_t here;
    };
    using namespace LAMMPS_NS;
    for (const Width &width : {Width{"bigint", sizeof(bigint)}, Width{"tagint", sizeof(tagint)},
                               Width{"imageint", sizeof(imageint)}}) {
        const int there = lammps_extract_setting(lmp, width.name);
        if (there != static_cast<int>(width.here)) {
            return "LAMMPS has a " + std::string(width.name) + " of " + std::to_string(there)
                + " bytes, and the plugin one of " + std::to_string(width.here)
                + "; build it with LAMMPS' own -DLAMMPS_SMALLBIG or -DLAMMPS_BIGBIG";
        }
    }
    return "";
}

int list_object(struct dl_phdr_info *info, size_t, void *names)
{
    if (info->dlpi_name && info->dlpi_name[0] != '\0') {
        static_cast<std::vector<std::string> *>(names)->push_back(info->dlpi_name);
    }
    return 0;
}

// Shared object of another copy of the plugin or of the C library; empty if there is none.
std::string other_copy()
{
    Dl_info own;
    // The mark's own name may lead to the other copy.
    if (!dladdr(reinterpret_cast<void *>(&list_object), &own)) return "";
    std::vector<std::string> names;
    dl_iterate_phdr(list_object, &names);
    for (const std::string &name : names) {
        void *object = dlopen(name.c_str(), RTLD_NOLOAD | RTLD_LAZY);
        if (!object) continue;
        std::string found;
        for (const char *symbol : {"amberfield_lammps_plugin", "amberfield_host_open"}) {
            Dl_info other;
            void *place = dlsym(object, symbol);
            if (place && dladdr(place, &other) && other.dli_fbase != own.dli_fbase) {
                found = other.dli_fname;
            }
        }
        dlclose(object);
        if (!found.empty()) return found;
    }
    return "";
}

// Ends a LAMMPS whose classes are not those of the headers, through its C library.
[[noreturn]] void end_other_version(LAMMPS_NS::LAMMPS *lmp, const std::string &message)
{
    using End = void (*)(void *, int, const char *);
    auto end = reinterpret_cast<End>(dlsym(RTLD_DEFAULT, "lammps_error"));
    if (end) end(lmp, LMP_ERROR_ALL, message.c_str());
    // That does not come back but from a LAMMPS which has no such function.
    std::fprintf(stderr, "ERROR: %s\n", message.c_str());
    std::_Exit(EXIT_FAILURE);
}

}    // namespace

void amberfield::check_program(LAMMPS_NS::LAMMPS *lmp)
{
    const std::string cannot = "the plugin amberfield cannot be used: ";
    using Version = int (*)(void *);
    auto version = reinterpret_cast<Version>(dlsym(RTLD_DEFAULT, "lammps_version"));
    std::string wrong = version ? wrong_version(version(lmp))
                                : "LAMMPS does not show its functions; link its program with -rdynamic";
    if (!wrong.empty()) end_other_version(lmp, cannot + wrong);
    wrong = wrong_mpi();
    if (wrong.empty()) wrong = wrong_widths(lmp);
    if (wrong.empty()) {
        const std::string copy = other_copy();
        if (!copy.empty()) {
            wrong = "the process has a second copy of amberfield, " + copy + "; load one of them only";
        }
    }
    if (!wrong.empty()) lmp->error->all(FLERR, cannot + wrong);
}
