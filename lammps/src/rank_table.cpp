// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "rank_table.h"

#include <climits>
#include <cstdio>

using amberfield::RankTable;

namespace {

// Ends all ranks where numbers are more than MPI counts: others wait for this one.
void end_for_too_many(MPI_Comm ranks)
{
    std::fprintf(stderr, "amberfield: a rank exchanges more than 2^31 numbers; use more ranks\n");
    MPI_Abort(ranks, 1);
}

}    // namespace

RankTable::RankTable(MPI_Comm world) : table_{}
{
    MPI_Comm_dup(world, &ranks_);
    int rank, count;
    MPI_Comm_rank(ranks_, &rank);
    MPI_Comm_size(ranks_, &count);
    table_.rank = rank;
    table_.count = count;
    table_.context = this;
    table_.exchange = exchange;
    table_.sum = sum;
    for (std::vector<int> *numbers : {&sent_, &sent_starts_, &received_, &received_starts_}) {
        numbers->resize(count);
    }
}

RankTable::~RankTable()
{
    MPI_Comm_free(&ranks_);
}

bool RankTable::lay_out(const uint64_t *counts, std::vector<int> &numbers, std::vector<int> &starts) const
{
    uint64_t start = 0;
    for (size_t rank = 0; rank < numbers.size(); ++rank) {
        if (start + counts[rank] > INT_MAX) return false;
        numbers[rank] = counts[rank];
        starts[rank] = start;
        start += counts[rank];
    }
    return true;
}

int32_t RankTable::exchange(void *self, const double *sent, const uint64_t *sent_counts, double *received,
                            const uint64_t *received_counts)
{
    RankTable &ranks = *static_cast<RankTable *>(self);
    if (!ranks.lay_out(sent_counts, ranks.sent_, ranks.sent_starts_)
        || !ranks.lay_out(received_counts, ranks.received_, ranks.received_starts_)) {
        end_for_too_many(ranks.ranks_);
    }
    return MPI_Alltoallv(sent, ranks.sent_.data(), ranks.sent_starts_.data(), MPI_DOUBLE, received,
                         ranks.received_.data(), ranks.received_starts_.data(), MPI_DOUBLE, ranks.ranks_);
}

int32_t RankTable::sum(void *self, double *values, uint64_t count)
{
    RankTable &ranks = *static_cast<RankTable *>(self);
    return MPI_Allreduce(MPI_IN_PLACE, values, static_cast<int>(count), MPI_DOUBLE, MPI_SUM, ranks.ranks_);
}
