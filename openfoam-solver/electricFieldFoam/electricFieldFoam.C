/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later

Application
    electricFieldFoam

Description
    Solves for the smooth part of the electric field of charged grains, which a
    DEM process moves, on the mesh of a case and with the boundary conditions of
    its field phiE.

Usage
    electricFieldFoam -case CASE [-run RUN]

\*---------------------------------------------------------------------------*/

#include "fvCFD.H"
#include "electricField.H"

int main(int argc, char *argv[])
{
    argList::addNote("The smooth electric field of charged grains, for amberfield.");
    argList::addOption("start", "name", "Time to start from, instead of that of controlDict");
    argList::addOption("run", "name", "Run of the DEM process; default: the one that waits");
    argList::noFunctionObjects();
    argList::noBanner();

    #include "setRootCase.H"
    #include "createTime.H"
    #include "startTime.H"
    #include "createMesh.H"

    string run;
    args.readIfPresent("run", run);

    fieldSide demProcess(run);
    electricField field(mesh, demProcess);

    while (demProcess.wait())
    {
        demProcess.mustBe(AmberfieldQuestion_Field);
        field.answer();
    }

    Info<< "The run is over." << nl << endl;

    return 0;
}
