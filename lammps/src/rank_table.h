// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_RANK_TABLE_H
#define AMBERFIELD_RANK_TABLE_H

#include "amberfield.h"

#include <mpi.h>

#include <vector>

namespace amberfield {

// The ranks of a communicator, as the library uses them. What the library sends goes by a communicator of
// its own.
class RankTable {
  public:
    explicit RankTable(MPI_Comm world);
    ~RankTable();
    RankTable(const RankTable &) = delete;
    RankTable &operator=(const RankTable &) = delete;

    const AmberfieldRanks *table() const { return &table_; }

  private:
    static int32_t exchange(void *self, const double *sent, const uint64_t *sent_counts, double *received,
                            const uint64_t *received_counts);
    static int32_t sum(void *self, double *values, uint64_t count);
    // Counts and places of numbers by rank; false where they are more than MPI counts.
    bool lay_out(const uint64_t *counts, std::vector<int> &numbers, std::vector<int> &starts) const;

    MPI_Comm ranks_;
    AmberfieldRanks table_;
    std::vector<int> sent_, sent_starts_, received_, received_starts_;
};

}    // namespace amberfield

#endif
