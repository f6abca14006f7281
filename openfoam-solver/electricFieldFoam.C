/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later

Application
    electricFieldFoam

Description
    Solves for the smooth part of the electric field of charged grains, whose
    positions and charges a DEM process shares:

        div(grad(V)) = -rho/epsilon,    E = -grad(V)

    with the boundary conditions of the case's field phiE, less what the DEM
    process computes itself.

Usage
    electricFieldFoam -case CASE -run RUN

\*---------------------------------------------------------------------------*/

#include "fvCFD.H"
#include "fieldSide.H"
#include "fixedGradientFvPatchFields.H"
#include "meshDescription.H"

int main(int argc, char *argv[])
{
    argList::addNote("The smooth electric field of charged grains, for amberfield.");
    argList::addOption("run", "name", "Run of the DEM process, as it says it");
    argList::noFunctionObjects();
    argList::noBanner();

    #include "setRootCase.H"
    #include "createTime.H"
    #include "createMesh.H"
    #include "createFields.H"

    fieldSide demProcess(args.get<string>("run"));
    demProcess.sendMesh(description);

    while (demProcess.wait())
    {
        #include "boundaryData.H"
        #include "VEqn.H"
        #include "electricField.H"

        demProcess.reply(V, E, performance.nIterations(), performance.finalResidual());
    }

    Info<< "The run is over." << nl << endl;

    return 0;
}
