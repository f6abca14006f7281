// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef LMP_FIX_AMBERFIELD_FIELD_H
#define LMP_FIX_AMBERFIELD_FIELD_H

#include "field_words.h"
#include "forecast.h"
#include "interval.h"
#include "kept_charges.h"
#include "shared_field.h"
#include "units.h"

#include "fix.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// fix ID group amberfield/field: adds qE to the forces on the charges of a group. E is evaluated every so
// many steps and goes on along the line through its last two evaluations in between.
class FixAmberfieldField : public Fix {
  public:
    FixAmberfieldField(LAMMPS *lmp, int narg, char **arg);
    ~FixAmberfieldField() override;

    int setmask() override;
    void init() override;
    void setup(int vflag) override;
    void min_setup(int vflag) override;
    void post_force(int vflag) override;
    void min_post_force(int vflag) override;
    void post_run() override;

    double compute_scalar() override;
    double compute_vector(int n) override;
    double memory_usage() override;

    void grow_arrays(int atoms) override;
    void copy_arrays(int from, int to, int delflag) override;
    void set_arrays(int i) override;
    int pack_exchange(int i, double *buffer) override;
    int unpack_exchange(int i, double *buffer) override;
    int pack_restart(int i, double *buffer) override;
    void unpack_restart(int nlocal, int nth) override;
    int size_restart(int nlocal) override;
    int maxsize_restart() override;
    void write_restart(FILE *file) override;
    void restart(char *buffer) override;

    // For the charge at contacts: the words, and the charges that E belongs to
    const amberfield::FieldWords &words() const { return words_; }
    double **field() const { return array_atom; }
    double charge_of_field(int i) const { return forecast_.knows(i) ? forecast_.charge[i] : 0.0; }
    // Charge on insulating walls, which takes part in the field
    void use_kept_charges(std::shared_ptr<const amberfield::KeptCharges> kept) { kept_ = std::move(kept); }
    // 1/(4 pi epsilon) in LAMMPS' units
    double coulomb() const { return source_.coulomb(); }

  private:
    // Sums over all atoms of the group that tell whether another evaluation is due
    struct Census {
        double changed;    // sum of (q - q of the last evaluation)^2; no number where an atom has come
        double squares;    // sum of q^2
        double count;
    };

    void check_setting();
    std::string coulomb_style() const;
    void check_computes(const std::function<void(const std::string &)> &refuse) const;
    bool virial_is_known() const;
    void start(int vflag);
    Census carry_on(double steps);
    bool is_due(const Census &census);
    void evaluate(const Census &census);
    double scale(const double *sums, const Census &census) const;
    double aim() const;
    void follow_error_of_field(double scale, const Census &census);
    double error_of_field() const;
    double longest() const;
    void add_virial();
    void give_kept_charges();
    amberfield::SharedField::Energy energy();
    // Sums that change where an atom was moved or charged by another command
    std::vector<double> fingerprint() const;

    const amberfield::Units units_;
    const amberfield::FieldWords words_;
    amberfield::SharedField source_;
    amberfield::Forecast forecast_;
    std::shared_ptr<const amberfield::KeptCharges> kept_;
    amberfield::Interval interval_;

    std::vector<double> fresh_;    // room for E as it comes, in rows
    std::vector<double *> rows_;
    bool is_fresh_due_ = true;
    bool is_restarted_ = false;
    double evaluated_count_ = 0.0;
    // Relative error of the field as it was measured last, and the scale of E over the RMS charge: then
    // and now
    double measured_ = 0.0, measured_at_ = 0.0, strength_ = 0.0;
    bigint last_step_ = -1;
    double last_dt_ = 0.0;
    bigint energy_step_ = -1;
    amberfield::SharedField::Energy energy_ = {0.0, 0.0};
    std::vector<double> left_at_;    // fingerprint at the end of the last run
};

}    // namespace LAMMPS_NS

#endif
