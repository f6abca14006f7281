// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_SHARED_FIELD_H
#define AMBERFIELD_SHARED_FIELD_H

#include "field_words.h"
#include "rank_table.h"
#include "units.h"

#include "amberfield.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace amberfield {

// How E comes to the atoms: every rank gives its own atoms to the library, which shares the field among the
// ranks. Nothing else of the plugin knows how E is found.
//
// All calls are collective, and all quantities are in LAMMPS' units. A failure ends the run.
class SharedField : protected LAMMPS_NS::Pointers {
  public:
    SharedField(LAMMPS_NS::LAMMPS *lmp, const char *fix, int groupbit, const FieldWords &words,
                const Units &units);
    ~SharedField() override;
    SharedField(const SharedField &) = delete;
    SharedField &operator=(const SharedField &) = delete;

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
    void collect();
    void check_place(int i) const;
    bool has_charges() const;
    void collect_charges_of_walls();
    std::vector<LAMMPS_NS::tagint> ids() const;
    // Ends the run where a call failed; it has failed on all ranks.
    void check(AmberfieldStatus status);
    void fit_open_faces();
    double time() const;
    int threads() const;

    const std::string fix_;
    const int groupbit_;
    const FieldWords words_;
    const Units units_;
    RankTable ranks_;
    // Ranks that share a machine with this one
    int beside_ = 1;
    AmberfieldHost *host_ = nullptr;
    std::string given_parameters_;
    double measured_error_ = -1.0;
    // Whether any charge has been there when parameters were chosen or looked at
    bool is_charged_ = false;
    // Box of the field
    double low_[3], high_[3];

    // Atoms of the group on this rank, their places and charges in SI, and E there
    std::vector<int> own_;
    std::vector<double> places_, charges_, e_;
    // Charges on walls, in SI
    std::vector<double> wall_places_, wall_charges_;
};

}    // namespace amberfield

#endif
