/* A host program: reads particles, one "x y z charge" a line [m, C], and prints E at each [V/m].
 *
 *     host EDGE          in a grounded cube of that edge [m], on the internal grid
 *     host EDGE CASE     the same through OpenFOAM: the walls are those of the case
 *
 * Link it with libamberfield_capi.a and -lgcc_s -lutil -lrt -lpthread -lm -ldl.
 */
#include "amberfield.h"

#include <stdio.h>
#include <stdlib.h>

enum { MOST = 100000 };

static double positions[3 * MOST], charges[MOST], e[3 * MOST], potential[MOST];

static int fail(AmberfieldHost *host)
{
    fprintf(stderr, "host: %s\n", amberfield_host_error(host));
    amberfield_host_close(host);
    return 1;
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "usage: host EDGE [CASE]\n");
        return 2;
    }
    AmberfieldHostSettings settings = {0}; /* all faces grounded */
    for (int axis = 0; axis < 3; ++axis) {
        settings.high[axis] = atof(argv[1]);
    }
    settings.tolerance = 1e-2;
    settings.model_tuning = 1;
    settings.openfoam_case = argc > 2 ? argv[2] : NULL;

    uint64_t count = 0;
    while (count < MOST
        && scanf("%lf %lf %lf %lf", &positions[3 * count], &positions[3 * count + 1],
                 &positions[3 * count + 2], &charges[count]) == 4) {
        ++count;
    }

    AmberfieldHost *host = amberfield_host_open(&settings);
    if (amberfield_host_error(host)[0] != '\0') {
        return fail(host);
    }
    /* As a code that moves its particles would: again and again, with one handle. */
    for (int step = 0; step < 3; ++step) {
        if (amberfield_host_field(host, 1e-6 * step, count, positions, charges, e, potential)
            != AmberfieldStatus_Ok) {
            return fail(host);
        }
    }
    for (uint64_t i = 0; i < count; ++i) {
        printf("%.17g %.17g %.17g %.17g\n", e[3 * i], e[3 * i + 1], e[3 * i + 2], potential[i]);
    }
    amberfield_host_close(host);
    return 0;
}
