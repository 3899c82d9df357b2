// What camera rays bring home, and the planes of sums that it is added to.
#ifndef VITRUM_FILM_H
#define VITRUM_FILM_H

// One ray's share of its pixel's radiance, field f of ray i at [f * stride + i].
#define SHARE_BEAUTY 0         // 3 floats [W/(m2 sr)]
#define SHARE_CAUSTICS 3       // 3 floats: what of it the photon map gives
#define SHARE_CUT 6            // weight of the branches that were cut
#define SHARE_FIELDS 7

// What direct light and the photon map need to know of a surface that scatters.
#define SCATTER_DIFFUSE 0      // 3 floats: weight times rho_d
#define SCATTER_SPECULAR 3     // 3 floats: weight times rho_s (s + 2) / (2 pi)
#define SCATTER_SHININESS 6
#define SCATTER_NORMAL 7       // 3 floats: shading normal on the side of the viewer
#define SCATTER_FIELDS 10

// The two rays that a dielectric makes of one.
#define CHILD_REFLECTED 0      // 3 floats: direction
#define CHILD_REFRACTED 3      // 3 floats: direction
#define CHILD_WEIGHT_REFLECTED 6
#define CHILD_WEIGHT_REFRACTED 9
#define CHILD_STACK_REFLECTED 12  // uint
#define CHILD_STACK_REFRACTED 13  // uint
#define CHILD_WHICH 14         // uint: bit 0 the reflected ray goes on, bit 1 the refracted one
#define CHILD_FIELDS 15

// The film: planes of sums over samples, plane p of pixel i at [p * stride + i].
#define FILM_BEAUTY 0          // 3 floats
#define FILM_CAUSTICS 3        // 3 floats
#define FILM_CUT 6
#define FILM_ALBEDO 7          // 3 floats
#define FILM_NORMAL 10         // 3 floats
#define FILM_DEPTH 13
#define FILM_PLANES 14

#endif
