// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

// What "fix amberfield/field" refuses, before a run begins.

#include "fix_amberfield_field.h"

#include "atom.h"
#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "pair.h"
#include "update.h"

#include <string>

using namespace LAMMPS_NS;

namespace {

const char *const AXES = "xyz";

// Conditions of LAMMPS' own boundary
enum { PERIODIC = 0, FIXED = 1 };

}    // namespace

void FixAmberfieldField::check_setting()
{
    const std::string me = "fix " + std::string(id) + " amberfield/field: ";
    const auto refuse = [&](const std::string &reason) { error->all(FLERR, me + reason); };

    if (!atom->q_flag) refuse("atoms have no charge; use atom_style hybrid sphere charge");
    if (lmp->kokkos) refuse("package kokkos keeps atoms elsewhere, which is not possible; run without it");
    if (domain->triclinic) refuse("a triclinic box is not possible; use an orthogonal one");
    if (domain->dimension != 3) refuse("the field has three dimensions; use dimension 3");
    if (force->kspace) {
        refuse("kspace_style " + std::string(force->kspace_style)
               + " sums the same charges; use kspace_style none");
    }
    const std::string coul = coulomb_style();
    if (!coul.empty()) refuse("pair_style " + coul + " sums the same charges; use one without coul");
    if (force->dielectric != 1.0) refuse("dielectric is not 1; give permittivity to this fix instead");
    if (std::string(update->integrate_style).find("respa") == 0) {
        refuse("run_style " + std::string(update->integrate_style) + " is not possible; use verlet");
    }
    for (Fix *fix : modify->get_fix_list()) {
        if (fix != this && std::string(fix->style) == style) {
            refuse("fix " + std::string(fix->id) + " is one too; charges of both would not see each other");
        }
        // Domains of the ranks may change.
        if (fix->box_change & ~BOX_CHANGE_DOMAIN) {
            refuse("fix " + std::string(fix->id) + " " + fix->style
                   + " changes the box while a run goes on, which is not possible; change_box between runs "
                     "is");
        }
    }
    const int axes = words_.openfoam_case.empty() ? 3 : 0;
    for (int axis = 0; axis < axes; ++axis) {
        const std::string name(1, AXES[axis]);
        if (words_.is_periodic(axis) != (domain->periodicity[axis] == 1)) {
            refuse(words_.is_periodic(axis)
                       ? name + " is periodic here and not in LAMMPS' boundary; give g, i or o"
                       : name + " is periodic in LAMMPS' boundary and not here; give p, or boundary f there");
        }
        for (int side = 0; side < 2; ++side) {
            const int face = 2 * axis + side;
            if (domain->boundary[axis][side] > FIXED && !words_.is_open(face)) {
                refuse("the face " + std::string(amberfield::FACE_NAMES[face])
                       + " shrinks in LAMMPS' boundary (s, m), so that only an open one (o) is possible; use "
                         "boundary f");
            }
        }
    }
    if (atom->molecular != Atom::ATOMIC && atom->nbonds > 0) {
        for (int neighbour = 1; neighbour < 4; ++neighbour) {
            if (force->special_coul[neighbour] != 1.0) {
                refuse("special_bonds leaves out charges of bonded atoms, which the field has; use "
                       "special_bonds coul 1 1 1");
            }
        }
    }
    check_computes(refuse);
    if (thermo_virial && !virial_is_known()) {
        refuse("the virial of a box with periodic axes and walls on others is not known; use fix_modify "
               "virial no");
    }
}

// A pair style that sums charges, among those of a hybrid one too; empty if there is none.
std::string FixAmberfieldField::coulomb_style() const
{
    const std::string whole = force->pair ? force->pair_style : "";
    for (const char *word : {"coul", "tip4p", "dipole"}) {
        // A number chooses among styles of a hybrid one; without it several are none.
        if (force->pair && (force->pair_match(word, 0, 0) || force->pair_match(word, 0, 1))) return whole;
    }
    return "";
}

// Refuses computes that ask for shares of single atoms in sums that are known as a whole.
void FixAmberfieldField::check_computes(const std::function<void(const std::string &)> &refuse) const
{
    for (const Compute *compute : modify->get_compute_list()) {
        const std::string name = "compute " + std::string(compute->id) + " " + compute->style;
        if (thermo_virial && compute->pressatomflag) {
            refuse(name + " asks for the virial of single atoms, of which only the sum is known; use "
                          "fix_modify virial no");
        }
        if (thermo_energy && compute->peatomflag) {
            refuse(name + " asks for the energy of single atoms, of which only the sum is known; use "
                          "fix_modify energy no, and f_" + std::string(id) + " beside it");
        }
    }
}

// Along axes with walls these bear a share of the virial that no force on an atom shows.
bool FixAmberfieldField::virial_is_known() const
{
    if (!words_.openfoam_case.empty()) return false;
    int periodic = 0, walls = 0;
    for (int axis = 0; axis < 3; ++axis) {
        periodic += words_.is_periodic(axis);
        walls += !words_.is_periodic(axis)
            && !(words_.is_open(2 * axis) && words_.is_open(2 * axis + 1));
    }
    return periodic == 0 || walls == 0;
}
