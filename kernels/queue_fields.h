// Rays that wait, and what they meet: structures of arrays, field f of ray i at [f * stride + i].
// Strides are multiples of 16, so that a work-item may read and write whole SIMD lanes past the end.
#ifndef VITRUM_QUEUE_FIELDS_H
#define VITRUM_QUEUE_FIELDS_H

// A ray leaves a mesh after error / cosine [m], the cosine to the facet's normal, and at grazing angles no later than this.
#define LEAST_COSINE 0.03f

#define RAY_ORIGIN 0           // 3 floats [m]: the unshifted point that the ray leaves
#define RAY_DIRECTION 3        // 3 floats, unit length
#define RAY_T_MIN 6            // [m]: hits at t <= t_min belong to the surface that the ray leaves
#define RAY_WEIGHT 7           // 3 floats: camera: R, T and transmittance so far; photon: power [W]
#define RAY_MEDIA 10           // uint: stack of media
#define RAY_FROM 11            // uint: exact shape that the ray leaves, or NO_INDEX
#define RAY_PATH 12            // uint: random bits of the path
#define RAY_SLOT 13            // uint: camera: pixel; photon: surfaces met so far
#define RAY_FIELDS 14

#define SURFACE_T 0            // [m], INFINITY: nothing is met
#define SURFACE_POSITION 1     // 3 floats [m], put back on the surface
#define SURFACE_NORMAL 4       // 3 floats: geometric normal, unit length, outwards
#define SURFACE_SHADING 7      // 3 floats: shading normal, unit length, on the same side
#define SURFACE_MATERIAL 10    // uint
#define SURFACE_ERROR 11       // [m]: bound of the distance between the position and the true surface
#define SURFACE_FROM 12        // uint: exact shape, for the rays that leave; NO_INDEX on a mesh
#define SURFACE_U 13           // texture coordinates
#define SURFACE_V 14
#define SURFACE_CONTACTS 15    // uint: borders in contact behind this one (kernels/contacts.h)
#define SURFACE_FIELDS 16

#endif
