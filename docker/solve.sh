#!/bin/sh
# Solves on the case in folder $1 for the run that waits, for a gas too where the case's application is
# amberPimpleFoam. Makes the mesh of a case that has only a recipe for it.
set -e
case_folder=$1
shift
[ -e "$case_folder/constant/polyMesh/points" ] || blockMesh -case "$case_folder" >&2
program=electricFieldFoam
! grep -q "^application *amberPimpleFoam" "$case_folder/system/controlDict" || program=amberPimpleFoam
exec "$program" -case "$case_folder" "$@"
