#!/bin/sh
# A run on one machine of a cluster, with electricFieldFoam in two ranks beside it. It stops with a checkpoint
# a minute before its time is over, and goes on from the last checkpoint when it is submitted again:
#
#     sbatch docker/slurm.sh scene.toml out
#
#SBATCH --job-name=amberfield
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=16
#SBATCH --mem=16G
#SBATCH --time=24:00:00
#SBATCH --signal=B:TERM@60
scene=$1
out=$2

# Both processes talk through /dev/shm: a rank of the solver must be on the run's machine, in one container
# with it or in none. With this image's MPI all are (docs/openfoam.md, "Over several machines").
set -- run "$scene" --out "$out" --no-progress --set solver.ranks=2
last=$(ls "$out"/checkpoints/*.amber 2>/dev/null | tail -n 1)
[ -z "$last" ] || set -- run "$scene" --resume "$last" --no-progress --set solver.ranks=2

apptainer run "${IMAGE:-amberfield.sif}" "$@" &
trap 'kill -TERM $!' TERM
wait $!
wait $!
