// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

// Interface between LAMMPS and a plugin, as LAMMPS' developer documentation publishes it. Packages of LAMMPS
// come without its header, so that it is declared here.

#ifndef AMBERFIELD_LAMMPSPLUGIN_H
#define AMBERFIELD_LAMMPSPLUGIN_H

extern "C" {

typedef void *(lammpsplugin_factory1)(void *);
typedef void *(lammpsplugin_factory2)(void *, int, char **);

// A style that a plugin brings.
typedef struct {
    // LAMMPS' version that it was compiled for
    const char *version;
    // Kind: "fix", "pair", ...
    const char *style;
    const char *name;
    const char *info;
    const char *author;
    // Maker of an instance: v1 takes LAMMPS alone, v2 the words of a command too
    union {
        lammpsplugin_factory1 *v1;
        lammpsplugin_factory2 *v2;
    } creator;
    // Shared object, as LAMMPS hands it over
    void *handle;
} lammpsplugin_t;

typedef void (*lammpsplugin_regfunc)(lammpsplugin_t *, void *);
}

#endif
