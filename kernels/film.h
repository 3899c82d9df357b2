// The film on the device: planes of sums over samples, plane p of the pixel in slot i at [p * stride + i].
#ifndef VITRUM_FILM_H
#define VITRUM_FILM_H

#define FILM_BEAUTY 0          // 3 floats [W/(m2 sr)]
#define FILM_CAUSTICS 3        // 3 floats: what of it the photon map gives
#define FILM_CUT 6             // weight of the branches that were cut
#define FILM_ALBEDO 7          // 3 floats; 1 where light goes on, in a mirror or in glass
#define FILM_NORMAL 10         // 3 floats: shading normal
#define FILM_DEPTH 13          // [m]
#define FILM_PLANES 14

// Slots that have the same number of samples; a multiple of every WIDTH.
#define SLOT_GROUP 16u

// Rays traced, and of all estimates of irradiance the sums of k and of k (k - 1), k being the number of photons in one; as
// low and high half.
#define COUNT_SECONDARY 0
#define COUNT_SHADOW 2
#define COUNT_GATHERED 4
#define COUNT_PAIRS 6
#define COUNTS 8

#endif
