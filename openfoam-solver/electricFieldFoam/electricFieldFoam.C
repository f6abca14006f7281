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
#include "caseChecks.H"
#include "caseFunctions.H"
#include "electricField.H"

namespace
{

void answerAll(const Foam::argList& args, Foam::fieldSide& demProcess)
{
    runClock runTime(args);
    caseChecks::checkMesh(runTime, demProcess);
    #include "createMesh.H"

    electricField field(mesh, demProcess);
    caseFunctions functions(runTime, demProcess, true);
    if (functions.any())
    {
        field.show("electricField");
    }
    field.sendMesh();

    while (demProcess.wait())
    {
        demProcess.mustBe(AmberfieldQuestion_Field);
        functions.advanceTo(demProcess.request().far.time_s);
        field.answer();
    }
    functions.execute();
    functions.end();

    Info<< "The run is over." << nl << endl;
}

} // End anonymous namespace


int main(int argc, char *argv[])
{
    argList::addNote("The smooth electric field of charged grains, for amberfield.");
    argList::addOption("start", "name", "Time to start from, instead of that of controlDict");
    argList::addOption("run", "name", "Run of the DEM process; default: the one that waits");
    argList::noBanner();

    #include "setRootCase.H"

    string run;
    args.readIfPresent("run", run);
    fieldSide demProcess(run);

    return demProcess.lead([&] { answerAll(args, demProcess); });
}
