// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_FIELD_WORDS_H
#define AMBERFIELD_FIELD_WORDS_H

#include "units.h"
#include "words.h"

#include "amberfield.h"

#include <string>

namespace amberfield {

// What the words of "fix amberfield/field" ask for, in SI.
struct FieldWords {
    double tolerance = 1e-2;
    // Faces in the order xlo, xhi, ylo, ...
    AmberfieldFace faces[6] = {};
    double permittivity = 1.0;
    // Folder of an OpenFOAM case; empty without one
    std::string openfoam_case;
    // Steps between two evaluations; 0: chosen by the error
    long every = 0;
    bool background = false;

    static FieldWords read(Words words, const Units &units);

    bool is_periodic(int axis) const { return faces[2 * axis].boundary == AmberfieldBoundary_Periodic; }
    bool is_open(int face) const { return faces[face].boundary == AmberfieldBoundary_Open; }

    // E [V/m] that the faces' potentials and normal fields make in a box of the given lengths [m], where it
    // is the same everywhere; false where it is not.
    bool given_field(const double *length, double *e) const;

  private:
    void read_boundary(Words &words);
    void read_face(Words &words, int face, const Units &units);
};

// Names of the faces, in their order.
extern const char *const FACE_NAMES[6];

}    // namespace amberfield

#endif
