// What lies in the scene's buffers. Host and device compile the same text; only floats and uints, so that both agree on
// every offset (a Vec3 is 16 bytes on one side and 12 on the other).
#ifndef VITRUM_TYPES_H
#define VITRUM_TYPES_H

#define NO_INDEX 0xffffffffu

// Exact sphere.
typedef struct {
  float centre[3];
  float radius;
  uint material;
  uint pad[3];
} SphereData;

// What part of its plane a flat shape covers, in its own coordinates (u, v).
#define FLAT_PLANE 0u          // all
#define FLAT_TRIANGLE 1u       // u >= 0, v >= 0, u + v <= 1
#define FLAT_PARALLELOGRAM 2u  // 0 <= u <= 1, 0 <= v <= 1
#define FLAT_DISC 3u           // u^2 + v^2 <= 1

// Plane, single triangle, parallelogram or disc: u = dot(p - point, u_axis), v = dot(p - point, v_axis).
typedef struct {
  float point[3];
  float normal[3];             // unit length
  float u_axis[3], v_axis[3];
  float texcoord[6];           // texture coordinates: (0,1) + u (2,3) + v (4,5)
  uint kind;                   // FLAT_...
  uint material;
} FlatData;

// The triangles of a mesh that have one material; to rays a shape of its own.
typedef struct {
  uint closed;                 // 1: of a dielectric, and each edge has faces on both sides: who enters it leaves it
  uint material;
  uint normals;                // its triangle t, of all meshes', has the normals normal_corners[normals + 3 t] and the
                               // next two, modulo 2^32; NO_INDEX: it is flat
  uint texcoords;              // the same for texture coordinates; NO_INDEX: it has none
} BodyData;

// A triangle's corners as indices of positions. The tree's `primitive` is its index among the triangles of all meshes.
typedef struct {
  uint position[3];
  uint shape;                  // after the exact shapes: the body's index
} TriangleData;

#define SURFACE_UNLIT 0u
#define SURFACE_OPAQUE 1u
#define SURFACE_MIRROR 2u
#define SURFACE_DIELECTRIC 3u

typedef struct {
  float emission[3];           // [W/(m2 sr)]
  uint surface;                // SURFACE_...
  float diffuse[3];            // rho_d
  uint texture;                // index into textures, or NO_INDEX
  float specular[3];           // Phong rho_s
  float shininess;             // Phong s
  uint medium;                 // of a dielectric: index into media
  uint texture_replaces;       // 1: rho_d = texel; 0: rho_d = texel * diffuse
  uint front_only;             // 1: emission is that of a light, shown by the front alone
  uint pad;
} MaterialData;

// media[0] is what is outside everything.
typedef struct {
  float sigma_a[3];            // [1/m], INFINITY is opaque
  float index;
  int priority;
  uint pad[3];
} MediumData;

// A border between two media (fresnel.cl's Interface as it lies in a buffer).
typedef struct {
  float eta, eta_inverse;      // n_t / n_i and its inverse
  float k_hi, k_lo;            // eta^2 - 1 in two floats
} InterfaceData;

typedef struct {
  uint first_texel;            // index into texels, counted in texels of 3 floats
  int width, height;
  uint bilinear;               // 0: nearest
  uint clamp;                  // 0: repeat
  float scale[2], offset[2];
  uint pad[3];
} TextureData;

#define LIGHT_POINT 0u
#define LIGHT_DIRECTIONAL 1u
#define LIGHT_QUAD 2u
#define LIGHT_DISC 3u
#define LIGHT_SPHERE 4u
#define LIGHT_MESH 5u

typedef struct {
  float position[3];           // point: position; quad: corner; disc, sphere: centre
  uint kind;                   // LIGHT_...
  float emitted[3];            // point: intensity [W/sr]; directional: irradiance [W/m2]; others: radiance [W/(m2 sr)]
  float radius;                // disc, sphere [m]
  float u[3];                  // quad: edge; disc: radius times unit vector
  float area;                  // [m2]
  float v[3];                  // as u
  uint shape;                  // of an area light: the shape that it is, which its own rays leave
  float normal[3];             // unit length; directional: the way the light travels
  uint media;                  // stack of media at the light
  uint first_face, face_count; // mesh: range in the faces
  float clearance;             // [m]: hits nearer than this belong to the light itself
  uint pad;
} LightData;

// A face of a mesh light, with Walker's alias table over area times radiance.
typedef struct {
  uint triangle;               // index into triangles
  float probability;           // of staying here
  uint alias;                  // face to go to otherwise, counted within the light
  float selection;             // probability of this face [1]
  float radiance[3];           // [W/(m2 sr)]
  uint pad;
} LightFace;

// Pinhole camera: the direction through (x, y) on the plane at distance 1 is forward + x right + y up.
typedef struct {
  float eye[3];                // [m]
  float left, top;             // x and y of the picture's upper left corner
  float step_x, step_y;        // size of a pixel
  float right[3], up[3], forward[3];  // unit vectors
  uint width, height;          // pixels
} CameraData;

// One sample of all pixels: what differs between its pixels follows from these and the pixel.
typedef struct {
  uint seed;                   // of the paths
  float x, y;                  // point of a sequence in the pixel
  float light_u, light_v;      // and on area lights
  float light_face;            // and for the face of a mesh light
} CameraSample;

// What refracts or mirrors, by its bounding sphere: photons are aimed at it.
typedef struct {
  float centre[3];
  float radius;                // [m]; INFINITY: unbounded
} CasterData;

#endif
