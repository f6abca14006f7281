// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_KEPT_CHARGES_H
#define AMBERFIELD_KEPT_CHARGES_H

#include "wall_place.h"

#include "pointers.h"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace amberfield {

// Charge that insulating walls keep, by the places at which grains left it, in LAMMPS' units. Contacts close
// by share a spot, whose place is the mean of theirs. The rules and numbers are those of amberfield's own
// runs: "Charge kept by insulating walls" in docs/equations.md.
//
// Every rank has all spots. What contacts leave in a step is added at its end, in the order of the atoms'
// ids: so the spots are the same on all ranks, and for any number of them.
class KeptCharges : protected LAMMPS_NS::Pointers {
  public:
    // A contact at which charge moves.
    struct Contact {
        int wall;
        bool bounds_field;    // the field has images in the surface
        double place[3];      // on the surface
        double inward[3];     // from the wall to the grain
        double radius;
    };

    // Field of the kept charges around a contact, positive from the wall to the grain, and its growth per
    // charge that the contact leaves, over 4 pi times Coulomb's constant.
    struct Felt {
        double normal_field;
        double per_charge;
    };

    // Numbers of a spot as others see it: place, charge, scale and wall, from 1
    static constexpr int COLUMNS = 6;

    KeptCharges(LAMMPS_NS::LAMMPS *lmp, int walls);

    // Begins a run: largest radius of the atoms, Coulomb's constant, and the box as it is.
    void begin(double largest_radius, double coulomb);

    // Makes sure that spots around an atom of a radius are found: one that came in the run may be the
    // largest.
    void cover(double radius);

    // Takes the spots of a wall along with its region, once in a step.
    void follow(int wall, LAMMPS_NS::Region *region);

    Felt felt(const Contact &contact) const;

    // Books what a contact of an atom leaves; `settle`, which is collective, adds it to the spots.
    void leave(const Contact &contact, double atom, int number, double charge);
    void settle();

    // Field along `out` at the centre of a grain that touches, which the evaluated field has of the kept
    // charges around. `image` is the sign of a field of images at the wall; 0: there is none.
    double in_evaluation(const Contact &contact, const double *centre, const double *out, double image) const;

    // Adds to E at a centre what it gains where the law's field takes the place of point charges.
    void soften(const double *centre, double *e) const;

    // Places and charges of the point charges that an evaluation takes, in rows.
    void sources(std::vector<double> &places, std::vector<double> &charges) const;

    int size() const { return spots_.size(); }
    double number(int spot, int column) const;

    // State in restart files.
    std::vector<double> pack() const;
    void unpack(const double *numbers);

  private:
    // Places and normals are those of the wall where it began.
    struct Spot {
        int wall;
        bool bounds_field;
        double place[3], normal[3], first[3];
        double scale, charge, moved;
    };
    struct Left {
        double atom, wall, number, bounds_field;
        double place[3], inward[3], radius, charge;
    };
    // A spot near a place, as both lie now.
    struct Near {
        const Spot *spot;
        double offset[3], normal[3];
    };

    int shared_spot(const Contact &contact) const;
    void add(const Contact &contact, double charge);
    void list(int spot);
    std::vector<Near> around(const double *place, double radius) const;
    void shortest(double *offset) const;
    void wrap(double *place) const;
    uint64_t cell_of(const double *place, int dx, int dy, int dz) const;
    void source(const Spot &spot, double *place) const;

    double largest_ = 0.0, cell_ = 0.0, coulomb_ = 0.0;
    std::vector<WallPlace> walls_;
    std::vector<Spot> spots_;
    // Spots of each wall in each cell and in those around it
    std::vector<std::unordered_map<uint64_t, std::vector<int>>> cells_;
    std::vector<Left> left_;
};

}    // namespace amberfield

#endif
