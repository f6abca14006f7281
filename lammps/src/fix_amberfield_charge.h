// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef LMP_FIX_AMBERFIELD_CHARGE_H
#define LMP_FIX_AMBERFIELD_CHARGE_H

#include "charge_words.h"
#include "kept_charges.h"
#include "units.h"

#include "amberfield.h"
#include "fix.h"

#include <memory>
#include <vector>

namespace LAMMPS_NS {

// fix ID group amberfield/charge: moves charge through contacts of grains, and of grains with walls,
// while their areas grow. What moves is the law's of the C library, for each contact with the charges at the
// beginning of the step: so the order of contacts, and of ranks, does not matter.
//
// Within post_force LAMMPS' velocities are those of the half step. Hence x - v dt is where a grain was one
// step ago, and a contact's growth needs no memory.
class FixAmberfieldCharge : public Fix {
  public:
    FixAmberfieldCharge(LAMMPS *lmp, int narg, char **arg);

    int setmask() override;
    void init() override;
    void init_list(int id, class NeighList *list) override;
    void setup(int vflag) override;
    void post_force(int vflag) override;

    double compute_scalar() override;
    double compute_vector(int n) override;
    double compute_array(int row, int column) override;
    double memory_usage() override;
    void write_restart(FILE *file) override;
    void restart(char *buffer) override;

    int pack_forward_comm(int count, int *list, double *buffer, int pbc_flag, int *pbc) override;
    void unpack_forward_comm(int count, int first, double *buffer) override;
    int pack_reverse_comm(int count, int first, double *buffer) override;
    void unpack_reverse_comm(int count, int *list, double *buffer) override;

  private:
    void make_table();
    double largest_radius() const;
    void see_ghosts();
    void trade_pairs();
    void trade_pair(int i, int j);
    void trade_walls();
    double trade_wall(int i, int wall, class Region *region, int contact);
    double image_at(int i, const double *normal, double distance) const;
    double field_at_wall(int i, const amberfield::KeptCharges::Contact &contact, double image) const;
    void check_relaxation();
    double walls() const;
    double insulators() const;
    AmberfieldContact contact(int type) const;

    const amberfield::Units units_;
    const amberfield::ChargeWords words_;
    class NeighList *list_ = nullptr;
    // The field of the same run; none: what others do at a contact is left out
    class FixAmberfieldField *field_ = nullptr;
    double permittivity_ = 1.0;
    double coulomb_ = 0.0;                   // in LAMMPS' units
    std::vector<double> area_factors_;       // of two types, by row
    std::vector<class Region *> regions_;    // of the walls
    // Charge on insulating walls, which the field has too; none without such walls
    std::shared_ptr<amberfield::KeptCharges> kept_;

    // Of own atoms and ghosts: charge gained in the step, and what neighbours see of the field
    std::vector<double> gained_;
    struct Seen {
        double e[3];
        double charge;    // that E belongs to
    };
    std::vector<Seen> seen_;
    std::vector<double> relaxed_;    // sum over an atom's contacts of what it relaxes in the step

    enum { CHARGE, FIELD } forwarded_ = CHARGE;
    double moved_ = 0.0;               // sum of the sizes of the charges that moved, of this rank
    std::vector<double> of_walls_;     // charge that each wall took, of this rank
};

}    // namespace LAMMPS_NS

#endif
