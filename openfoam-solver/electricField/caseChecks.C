/*---------------------------------------------------------------------------*\
    amberfield: the electric field of charged grains
    SPDX-License-Identifier: GPL-3.0-or-later
\*---------------------------------------------------------------------------*/

#include "caseChecks.H"
#include "IOdictionary.H"
#include "OSspecific.H"
#include "Time.H"

namespace
{

//- A dictionary below constant; empty where there is none
Foam::dictionary inConstant(const char* name, const Foam::Time& time)
{
    Foam::IOobject io
    (
        name, time.constant(), time, Foam::IOobject::MUST_READ, Foam::IOobject::NO_WRITE, false
    );
    if (!io.typeHeaderOk<Foam::IOdictionary>(true))
    {
        return Foam::dictionary();
    }
    return Foam::IOdictionary(io);
}

//- Refuses a scheme in time for a term, unless a checkpoint can hold it
void checkScheme(const Foam::word& term, const Foam::fvMesh& mesh, Foam::fieldSide& demProcess)
{
    Foam::ITstream& entry = mesh.ddtScheme(term);
    Foam::word scheme(entry);
    if (scheme == "bounded")
    {
        entry >> scheme;
    }
    if (scheme != "Euler" && scheme != "backward")
    {
        demProcess.refuse
        (
            "ddtSchemes of system/fvSchemes has " + scheme + " for " + term
          + "; the gas is possible with Euler and backward only, whose state a checkpoint holds"
        );
    }
}

} // End anonymous namespace


void Foam::caseChecks::checkMesh(const Time& time, fieldSide& demProcess)
{
    const fileName constant(time.path()/time.constant());
    if (!isDir(constant/"polyMesh") && !isDir(time.timePath()/"polyMesh"))
    {
        for (const fileName& region : readDir(constant, fileName::DIRECTORY))
        {
            if (isDir(constant/region/"polyMesh"))
            {
                demProcess.refuse
                (
                    "the case has regions (constant/" + region + "/polyMesh) and no mesh of its own in"
                    " constant/polyMesh; make a case of the one region in which the grains are"
                );
            }
        }
    }
    const word moves
    (
        inConstant("dynamicMeshDict", time).getOrDefault<word>("dynamicFvMesh", "staticFvMesh")
    );
    if (moves != "staticFvMesh")
    {
        demProcess.refuse
        (
            "constant/dynamicMeshDict has dynamicFvMesh " + moves + ", but the mesh must stay;"
            " remove the file, or give it staticFvMesh"
        );
    }
}


void Foam::caseChecks::checkGas(const fvMesh& mesh, fieldSide& demProcess)
{
    for (const entry& zone : inConstant("MRFProperties", mesh.time()))
    {
        if (zone.isDict() && zone.dict().getOrDefault("active", true))
        {
            demProcess.refuse
            (
                "constant/MRFProperties has the zone " + zone.keyword() + ", but frames that rotate"
                " (MRF) are not possible; remove it, or give it \"active no;\""
            );
        }
    }
    checkScheme("ddt(alpha)", mesh, demProcess);
    checkScheme("ddt(alpha,U)", mesh, demProcess);
}
