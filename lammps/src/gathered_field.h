// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_GATHERED_FIELD_H
#define AMBERFIELD_GATHERED_FIELD_H

#include "field_words.h"
#include "units.h"

#include "amberfield.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace amberfield {

// How E comes to the atoms: positions and charges of all ranks go to rank 0, which computes the field, and E
// is scattered. Nothing else of the plugin knows how E is found, so that another class can take its place.
//
// All calls are collective, and all quantities are in LAMMPS' units. A failure ends the run.
class GatheredField : protected LAMMPS_NS::Pointers {
  public:
    GatheredField(LAMMPS_NS::LAMMPS *lmp, const char *fix, int groupbit, const FieldWords &words,
                  const Units &units);
    ~GatheredField() override;
    GatheredField(const GatheredField &) = delete;
    GatheredField &operator=(const GatheredField &) = delete;

    // Takes the box as it is; where it has changed, parameters are chosen anew. Returns whether it has.
    bool follow_box();

    // Writes E at the rank's own atoms; others of the group are not touched. With `recheck` the error is
    // measured first, and parameters are chosen anew where it has left the tolerance.
    void evaluate(double **e, bool recheck);

    // Charges at places that are no atoms', the same on all ranks. Evaluations have them among their sources.
    void set_charges_of_walls(const std::vector<double> &places, const std::vector<double> &charges);

    // Energy of the charges, whose change with their places is the force.
    struct Energy {
        double of_charges;    // among themselves, with images
        double of_faces;      // in the field of the faces' potentials and normal fields
    };
    Energy energy();

    // Relative error of E that was measured last; below 0 where none was.
    double measured_error() const { return measured_error_; }

    // Parameters as text, on rank 0, and their way back before the first evaluation.
    std::string parameters() const;
    void use_parameters(const std::string &text) { given_parameters_ = text; }

    // 1/(4 pi epsilon) over LAMMPS' units: a charge times it over a distance squared is a field.
    double coulomb() const;

  private:
    void open();
    void close();
    void gather();
    void check_place(int i) const;
    bool has_charges() const;
    // Ends the run on all ranks where rank 0 failed.
    void check(bool failed);
    void fit_open_faces();
    double time() const;
    int threads() const;

    const std::string fix_;
    const int groupbit_;
    const FieldWords words_;
    const Units units_;
    // Ranks that share a machine with this one
    int beside_ = 1;
    AmberfieldHost *host_ = nullptr;
    std::string given_parameters_;
    double measured_error_ = -1.0;
    // Whether any charge has been there when parameters were chosen or looked at
    bool is_charged_ = false;
    // Box of the field
    double low_[3], high_[3];

    // Of this rank: atoms of the group, and their places and charges
    std::vector<int> own_;
    std::vector<double> own_places_, own_charges_;
    std::vector<LAMMPS_NS::tagint> own_tags_;
    // Charges on walls, in SI
    std::vector<double> wall_places_, wall_charges_;
    // Of all ranks, on rank 0: as they come, and in the order of their ids
    std::vector<int> counts_, starts_, counts3_, starts3_;
    std::vector<double> gathered_, places_, charges_, e_;
    std::vector<LAMMPS_NS::tagint> tags_;
    std::vector<int> order_;
};

}    // namespace amberfield

#endif
