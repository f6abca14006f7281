// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "field_words.h"

#include <cmath>
#include <cstring>

using amberfield::FieldWords;
using amberfield::Words;

const char *const amberfield::FACE_NAMES[6] = {"xlo", "xhi", "ylo", "yhi", "zlo", "zhi"};

namespace {

const char *const ALLOWED = "tolerance, boundary, xlo, xhi, ylo, yhi, zlo, zhi, permittivity, every, "
                            "background, case";
const char *const LETTERS = "p (periodic), g (grounded), i (insulating), o (open), one for both faces of an "
                            "axis or two for the lower and the upper";

bool boundary_of(char letter, uint64_t &boundary, bool &known)
{
    known = true;
    switch (letter) {
        case 'p': boundary = AmberfieldBoundary_Periodic; break;
        case 'g': boundary = AmberfieldBoundary_Grounded; break;
        case 'i': boundary = AmberfieldBoundary_NormalField; break;
        case 'o': boundary = AmberfieldBoundary_Open; break;
        default: known = false;
    }
    return known;
}

}    // namespace

FieldWords FieldWords::read(Words words, const Units &units)
{
    FieldWords read;
    bool has_boundary = false;
    while (words.any()) {
        const std::string word = words.next("a word");
        if (word == "tolerance") {
            read.tolerance = words.above("the relative error of E", 0.0);
            if (read.tolerance >= 1.0) words.refuse("the tolerance is a relative error of E, below 1");
        } else if (word == "boundary") {
            read.read_boundary(words);
            has_boundary = true;
        } else if (word == "permittivity") {
            read.permittivity = words.number("the relative permittivity");
            if (read.permittivity < 1.0) words.refuse("the relative permittivity is 1 or more");
        } else if (word == "every") {
            const std::string steps = words.next("auto or a number of steps");
            char *end = nullptr;
            read.every = steps == "auto" ? 0 : std::strtol(steps.c_str(), &end, 10);
            if (steps != "auto" && (*end != '\0' || read.every < 1)) {
                words.refuse(steps, "auto, or a number of steps from 1 on");
            }
        } else if (word == "background") {
            read.background = words.yes("whether a net charge is balanced");
        } else if (word == "case") {
            read.openfoam_case = words.next("the folder of an OpenFOAM case");
        } else {
            int face = 0;
            while (face < 6 && word != FACE_NAMES[face]) ++face;
            if (face == 6) words.refuse(word, ALLOWED);
            if (!has_boundary) words.refuse("'" + word + "' stands behind boundary");
            read.read_face(words, face, units);
        }
    }
    if (has_boundary != read.openfoam_case.empty()) {
        words.refuse(has_boundary ? "boundary and case are both given; with a case its patches count"
                                  : "boundary is missing; give it for x, y and z, or case DIR");
    }
    return read;
}

void FieldWords::read_boundary(Words &words)
{
    for (int axis = 0; axis < 3; ++axis) {
        const std::string word = words.next("boundary for x, y and z");
        bool known = word.size() == 1 || word.size() == 2;
        for (int side = 0; side < 2 && known; ++side) {
            boundary_of(word[side == 1 ? word.size() - 1 : 0], faces[2 * axis + side].boundary, known);
        }
        if (!known) words.refuse(word, LETTERS);
        if ((word[0] == 'p') != (word[word.size() - 1] == 'p')) {
            words.refuse("'" + word + "': an axis is periodic on both sides or on none");
        }
    }
}

void FieldWords::read_face(Words &words, int face, const Units &units)
{
    const std::string word = words.next("potential or normal_field");
    if (word != "potential" && word != "normal_field") words.refuse(word, "potential, normal_field");
    if (faces[face].boundary == AmberfieldBoundary_Periodic) {
        words.refuse("the face " + std::string(FACE_NAMES[face]) + " is periodic and takes no " + word);
    }
    const bool is_potential = word == "potential";
    faces[face].boundary = is_potential ? AmberfieldBoundary_Potential : AmberfieldBoundary_NormalField;
    const double value = words.number(word + " of the face");
    faces[face].value = value * (is_potential ? units.potential : units.field);
}

bool FieldWords::given_field(const double *length, double *e) const
{
    int with_values = -1, with_walls = 0;
    for (int axis = 0; axis < 3; ++axis) {
        e[axis] = 0.0;
        bool has_value = false;
        for (int face = 2 * axis; face < 2 * axis + 2; ++face) has_value |= faces[face].value != 0.0;
        // Conductors at the sides bend a field.
        const auto conducts = [this](int face) {
            return faces[face].boundary == AmberfieldBoundary_Grounded
                || faces[face].boundary == AmberfieldBoundary_Potential;
        };
        with_walls += conducts(2 * axis) || conducts(2 * axis + 1);
        if (!has_value) continue;
        if (with_values >= 0) return false;
        with_values = axis;
        const AmberfieldFace &low = faces[2 * axis], &high = faces[2 * axis + 1];
        if (conducts(2 * axis) && conducts(2 * axis + 1)) {
            e[axis] = (low.value - high.value) / length[axis];
        } else if (low.boundary == AmberfieldBoundary_NormalField && !is_open(2 * axis + 1)) {
            e[axis] = -low.value;
        } else if (high.boundary == AmberfieldBoundary_NormalField && !is_open(2 * axis)) {
            e[axis] = high.value;
        } else {
            return false;
        }
    }
    return with_values < 0 || with_walls <= 1;
}
