// What the scene needs, as -D switches made by the host's scene_features (src/scene/features.hpp). A switch that is off
// compiles to nothing. A missing one is our bug, so it stops the build here and not as a wrong picture.
#ifndef VITRUM_SWITCHES_H
#define VITRUM_SWITCHES_H

#ifndef HAS_MESH
#error "HAS_MESH: 1 if there are triangle meshes, and so a tree"
#endif
#ifndef HAS_DIELECTRIC
#error "HAS_DIELECTRIC: 1 if light is refracted anywhere"
#endif
#ifndef HAS_MEDIA_STACK
#error "HAS_MEDIA_STACK: 1 if media may touch or overlap; 0 lets a ray be in one medium at most"
#endif
#ifndef HAS_CONTACTS
#error "HAS_CONTACTS: 1 if a transparent mesh may touch another shape"
#endif
#ifndef HAS_ABSORPTION
#error "HAS_ABSORPTION: 1 if any medium absorbs"
#endif
#ifndef HAS_TEXTURES
#error "HAS_TEXTURES: 1 if any surface has a texture"
#endif
#ifndef HAS_HIGHLIGHTS
#error "HAS_HIGHLIGHTS: 1 if any surface has a Phong term"
#endif
#ifndef HAS_DIRECT_LIGHT
#error "HAS_DIRECT_LIGHT: 1 if lights shine on what scatters"
#endif
// How the photon map is gathered.
#define CAUSTICS_NONE 0
#define CAUSTICS_WITHIN 1
#define CAUSTICS_NEAREST 2
#define CAUSTICS_FOOTPRINTS 3
#ifndef CAUSTICS
#error "CAUSTICS: one of CAUSTICS_..."
#endif
#ifndef HAS_PATCHES
#error "HAS_PATCHES: 1 if what photons light is drawn where it is seen directly; they are on lattices, then"
#endif
#ifndef CAMERA_STACK
#error "CAMERA_STACK: packets of camera rays that may wait, at least the greatest depth and one more"
#endif
#ifndef LIGHT_KINDS
#error "LIGHT_KINDS: a bit set of the kinds of light in the scene, 1 << LIGHT_..."
#endif

#endif
