/* Kairos from C (C99), and from all that can call C: docs/c.md.
 *
 * Every function that can fail returns a kairos_status; kairos_last_error() then has one line that says what, where,
 * and what to do. Objects are opaque and counted: who gets one has one reference to it, and gives it back by
 * kairos_..._release, which bears NULL. What an object was made of may be released before it.
 *
 * Structs that are passed in begin with `struct_size`, to be set to their sizeof. All other members may be zero: zero,
 * and NULL, stand for the default. A struct grows at its end alone; a library reads as much of it as the program's
 * header had, and what is not there has its default. Text is UTF-8; names of choices are those of the command line.
 *
 * Objects are immutable but for workspaces and renderers, which one thread at a time may use; all else may be used from
 * any number of threads. Units, spaces and conventions are those of the C++ headers. */
#ifndef KAIROS_KAIROS_H
#define KAIROS_KAIROS_H

#include <stddef.h>
#include <stdint.h>

#include <kairos/export.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef int32_t kairos_status;
enum {
  KAIROS_OK = 0,
  KAIROS_BAD_INPUT = 1, /* a file or a scene that cannot be used */
  KAIROS_BAD_USAGE = 2, /* arguments that make no sense */
  KAIROS_IO = 3,        /* the system refused to read or write */
  KAIROS_CANCELLED = 4, /* the progress function asked to stop */
  KAIROS_NO_MEMORY = 5,
  KAIROS_INTERNAL = 6 /* a fault of Kairos' */
};

/* "major.minor.patch" of the library that is linked. */
KAIROS_API const char* kairos_version(void);
/* Of the last call of this thread that failed; valid until the next one that does. */
KAIROS_API const char* kairos_last_error(void);

typedef struct kairos_scene kairos_scene;
typedef struct kairos_shot kairos_shot;
typedef struct kairos_renderer kairos_renderer;
typedef struct kairos_image kairos_image;
typedef struct kairos_tracer kairos_tracer;
typedef struct kairos_workspace kairos_workspace;
typedef struct kairos_hits kairos_hits;

KAIROS_API void kairos_scene_retain(kairos_scene* scene);
KAIROS_API void kairos_scene_release(kairos_scene* scene);
KAIROS_API void kairos_shot_retain(kairos_shot* shot);
KAIROS_API void kairos_shot_release(kairos_shot* shot);
KAIROS_API void kairos_renderer_retain(kairos_renderer* renderer);
KAIROS_API void kairos_renderer_release(kairos_renderer* renderer);
KAIROS_API void kairos_image_retain(kairos_image* image);
KAIROS_API void kairos_image_release(kairos_image* image);
KAIROS_API void kairos_tracer_retain(kairos_tracer* tracer);
KAIROS_API void kairos_tracer_release(kairos_tracer* tracer);
KAIROS_API void kairos_workspace_release(kairos_workspace* workspace);
KAIROS_API void kairos_hits_retain(kairos_hits* hits);
KAIROS_API void kairos_hits_release(kairos_hits* hits);

/* ---- Rays in, segments out ---- */

/* Points origin + dist * direction, dist > 0; the direction of any length but zero. */
typedef struct kairos_ray {
  float origin[3], direction[3];
} kairos_ray;

/* The stretch of shutter time [begin, end) in which a ray sees one triangle. */
typedef struct kairos_segment {
  float begin, end;           /* 0 <= begin < end <= 1 */
  float dist_begin, dist_end; /* at both ends, in units of the direction's length */
  uint32_t mesh, triangle;    /* indices */
  uint8_t front;              /* 1: the side is seen on which the vertices run counter-clockwise */
  uint8_t reserved[3];
} kairos_segment;

typedef struct kairos_time_range {
  float begin, end; /* shutter time, [begin, end) */
} kairos_time_range;

/* Vertices that move on straight lines between keys. What the pointers lead to is copied. */
typedef struct kairos_mesh {
  uint32_t struct_size;
  uint32_t material; /* index; of no concern to a tracer */
  const char* name;
  size_t triangle_count, vertex_count;
  size_t key_count;              /* 0 stands for 1: it stands still */
  const uint32_t* triangles;     /* [triangle_count][3] */
  const float* key_times;        /* [key_count], of a single key NULL; for a tracer ascending from 0 to 1 */
  const float* const* positions; /* [key_count], each the first of vertex_count times x, y, z */
  size_t stride;                 /* bytes from vertex to vertex; 0: three floats */
  int32_t one_sided;             /* a triangle is there only from its front; in scenes materials say so */
  /* Of a scene; of no concern to a tracer. */
  const float* const* normals; /* NULL, or [key_count], each vertex_count times x, y, z */
  const float* uvs;            /* NULL, or [vertex_count][2]; (0, 0) is a picture's upper left corner */
} kairos_mesh;

/* Where surfaces are missing. Called from many threads at once; may not throw, nor call back into Kairos. */
typedef struct kairos_cut_outs {
  uint32_t struct_size;
  void* user; /* handed to the functions */
  /* 0 when nothing of the mesh is ever missing. */
  int (*has)(void* user, uint32_t mesh);
  /* Writes when, during the hit, the surface is there: begin, end, begin, end, ..., ascending. Returns how many numbers
   * that makes, which is asked for again with more room where it is more than `capacity`. */
  size_t (*solid_times)(void* user, const kairos_ray* ray, const kairos_segment* hit, float* times, size_t capacity);
  /* Not 0 where the surface is there at `time`, at the point in which the ray meets the triangle. Asked in place of the
   * other about hits that last for all of the shutter on what stands still. */
  int (*solid)(void* user, const kairos_ray* ray, uint32_t mesh, uint32_t triangle, float time);
} kairos_cut_outs;

typedef struct kairos_tracer_options {
  uint32_t struct_size;
  int32_t fast;                    /* float arithmetic, as for pictures; packets need it. 0: double */
  const char* instruction_set;     /* "scalar", "sse4", "avx2", "avx512" or "neon"; NULL: the best one */
  const kairos_cut_outs* cut_outs; /* copied; `user` must outlive the tracer. NULL: all surfaces are whole */
  int32_t threads;                 /* of kairos_query; 0: as many as the machine has */
} kairos_tracer_options;

/* When a ray looks, and how far; NULL in its place: always, and without end. */
typedef struct kairos_limits {
  float window_begin, window_end; /* shutter time, 0 <= window_begin < window_end <= 1 */
  float max_dist;                 /* in units of the direction's length; may be infinite */
} kairos_limits;

/* What a query gives. */
enum {
  KAIROS_VISIBLE = 0, /* what is nearest, and when: disjoint, in order of time */
  KAIROS_ALL = 1      /* every triangle met, hidden or not, by begin, then mesh, then triangle */
};

KAIROS_API kairos_status kairos_make_tracer(const kairos_mesh* meshes, size_t mesh_count,
                                            const kairos_tracer_options* options, kairos_tracer** out);
/* Of a shot's meshes, in its space; for rays in world space make the shot so. */
KAIROS_API kairos_status kairos_make_shot_tracer(const kairos_shot* shot, const kairos_tracer_options* options,
                                                 kairos_tracer** out);
/* Scratch memory, one for each thread that traces single rays or packets. */
KAIROS_API kairos_status kairos_make_workspace(kairos_workspace** out);

/* One ray. The segments lie in the workspace until its next use. */
KAIROS_API kairos_status kairos_trace(const kairos_tracer* tracer, kairos_workspace* workspace, const kairos_ray* ray,
                                      int32_t what, const kairos_limits* limits, const kairos_segment** segments,
                                      size_t* count);
/* Up to 16 rays at once, cheaper where they go about the same way; of a tracer with `fast`. segments, counts:
 * [ray_count]. */
KAIROS_API kairos_status kairos_trace_packet(const kairos_tracer* tracer, kairos_workspace* workspace,
                                             const kairos_ray* rays, size_t ray_count, int32_t what,
                                             const kairos_limits* limits, const kairos_segment** segments,
                                             size_t* counts);
/* When anything is met: disjoint, in order; the ranges lie in the workspace until its next use. */
KAIROS_API kairos_status kairos_occluded(const kairos_tracer* tracer, kairos_workspace* workspace,
                                         const kairos_ray* ray, const kairos_limits* limits,
                                         const kairos_time_range** ranges, size_t* count);
/* Many rays, in parallel; the same for any number of threads. */
KAIROS_API kairos_status kairos_query(const kairos_tracer* tracer, const kairos_ray* rays, size_t ray_count,
                                      int32_t what, const kairos_limits* limits, kairos_hits** out);
/* Of ray i: segments[offsets[i]] to segments[offsets[i + 1]]. Both lie in the hits. */
KAIROS_API kairos_status kairos_hits_data(const kairos_hits* hits, const kairos_segment** segments,
                                          size_t* segment_count, const size_t** offsets, size_t* ray_count);

/* ---- Scenes and pictures ---- */

typedef struct kairos_load_options {
  uint32_t struct_size;
  int32_t strict;         /* what is bad or not supported is an error */
  const char* animation;  /* name or index, "all" or "none"; NULL: the first */
  const char* gltf_scene; /* name or index; NULL: the file's own */
  const char* root;       /* the folder in which all lies that files may name; NULL: that of each file */
  uint64_t memory_budget; /* bytes beside 1024 for each of the files'; 0: 2^30 */
  int32_t threads;
} kairos_load_options;

KAIROS_API kairos_status kairos_load(const char* const* paths, size_t path_count, const kairos_load_options* options,
                                     kairos_scene** out);

/* ---- Scenes from memory ---- */

enum {
  KAIROS_OPAQUE = 0,
  KAIROS_MASK = 1, /* missing where alpha is below the cut-off */
  KAIROS_BLEND = 2
};

/* Colours are linear Rec. 709. Not all defaults are zero: kairos_material_init sets them. */
typedef struct kairos_material {
  uint32_t struct_size;
  int32_t one_sided, unlit;
  int32_t alpha_mode; /* KAIROS_OPAQUE, ... */
  const char* name;
  const char* base_color_picture; /* a file that multiplies base_color, and its alpha `alpha`; NULL: none */
  float base_color[3], emission[3];
  float metallic, roughness, transmission, ior;
  float alpha, alpha_cutoff;
} kairos_material;
/* A grey surface. struct_size: the struct's sizeof. */
KAIROS_API kairos_status kairos_material_init(kairos_material* material, uint32_t struct_size);

typedef struct kairos_camera {
  uint32_t struct_size;
  int32_t orthographic;
  const char* name;
  double vfov_degrees, view_height; /* perspective; orthographic, world units. 0: 45, 2 */
  size_t key_count;                 /* 0 stands for 1 */
  const double* key_times;          /* [key_count] seconds, ascending; of a single key NULL */
  const double* to_world;           /* [key_count][4][4], row by row; the camera looks along -z, y up */
} kairos_camera;

enum { KAIROS_POINT_LIGHT = 0, KAIROS_SPOT_LIGHT = 1, KAIROS_DIRECTIONAL_LIGHT = 2, KAIROS_CONSTANT_LIGHT = 3 };
typedef struct kairos_light {
  uint32_t struct_size;
  int32_t kind;
  float position[3], direction[3]; /* direction: in which the light travels */
  float brightness[3];             /* intensity, of a directional light irradiance, of a constant one radiance */
  float cos_inner, cos_outer;      /* of a spot: up to where it is full, from where there is none */
} kairos_light;

/* What the pointers lead to is copied. Meshes' key_times are seconds, and may be any that ascend. */
typedef struct kairos_scene_description {
  uint32_t struct_size;
  const kairos_mesh* meshes;
  const kairos_material* materials; /* none: a grey one */
  const kairos_camera* cameras;     /* none: one that frames everything */
  const kairos_light* lights;
  size_t mesh_count, material_count, camera_count, light_count;
  float background[3];
  double fps; /* frames per second, in which a shot's times are given; 0: 24 */
} kairos_scene_description;
KAIROS_API kairos_status kairos_make_scene(const kairos_scene_description* description, kairos_scene** out);

typedef struct kairos_shot_options {
  uint32_t struct_size;
  int32_t has_frame, has_shutter;     /* 1: the members below count */
  int32_t width, height;              /* pixels; 0: the scene's own */
  int32_t world_space;                /* 1: for a tracer whose rays are in world space */
  double frame;                       /* from which the shutter's times are counted */
  double shutter_open, shutter_close; /* frames */
  double fps;                         /* 0: the scene's own */
  double motion_tolerance;            /* pixels; 0: 0.1 */
  const char* camera;                 /* name or index; NULL: the first, or one that frames everything */
  const char* lights;                 /* "auto", "file", "studio" or "none"; NULL: auto */
  int32_t strict, threads;
  /* A picture of all that is far away, by latitude and longitude (HDR or EXR); NULL: the scene's own. */
  const char* environment;
  double environment_rotation; /* degrees, counter-clockwise seen from above */
  double environment_strength; /* what it is multiplied by; 0: 1 */
  int32_t transparent;         /* 1: nothing is seen beyond everything, and pictures have a channel "A" */
  int32_t has_background;      /* 1: the colour below is seen there in place of the environment */
  float background[3];
} kairos_shot_options;

KAIROS_API kairos_status kairos_make_shot(const kairos_scene* scene, const kairos_shot_options* options,
                                          kairos_shot** out);
KAIROS_API kairos_status kairos_shot_size(const kairos_shot* shot, int32_t* width, int32_t* height);
KAIROS_API kairos_status kairos_shot_mesh_count(const kairos_shot* shot, size_t* count);
/* The text lies in the shot. */
KAIROS_API kairos_status kairos_shot_mesh_name(const kairos_shot* shot, size_t mesh, const char** name);

/* Keeps what is expensive for the next picture. */
KAIROS_API kairos_status kairos_make_renderer(kairos_shot* shot, kairos_renderer** out);

typedef struct kairos_render_params {
  uint32_t struct_size;
  int32_t spp, tc_rays, shading_samples; /* 0: 64, 16, 8 */
  const char* integrator;                /* NULL: auto */
  const char* shading;                   /* NULL: whitted */
  const char* sampler;                   /* NULL: owen-sobol */
  const char* filter;                    /* NULL: box */
  const char* aovs;                      /* further channels, separated by commas: "depth,coverage" */
  const char* instruction_set;           /* NULL: the best one */
  uint64_t seed;
  int32_t crop[4]; /* x0, x1, y0, y1; all 0: the whole frame */
  int32_t threads;
  int32_t max_depth;   /* how often light is mirrored, refracted or (path) scattered, at most 64; 0: 8; -1: never */
  float clamp;         /* path: the most that a sample brings of what is scattered more than once; 0: all of it */
  const char* shadows; /* of lit pictures, see --shadows: "auto", "sampled" or "exact"; NULL: auto */
  const char* cells;   /* of lit pictures, light that pixels share, see --cells: "auto", "on" or "off"; NULL: auto */
  const char* mirrors; /* what they show, see --mirrors: "auto", "sampled" or "exact"; NULL: auto */
} kairos_render_params;

/* Told the fraction done by the thread that called, about twenty times a second; 0 stops. May be NULL. */
typedef int (*kairos_progress)(void* user, double fraction);

KAIROS_API kairos_status kairos_render(kairos_renderer* renderer, const kairos_render_params* params,
                                       kairos_progress progress, void* user, kairos_image** out);
KAIROS_API kairos_status kairos_image_size(const kairos_image* image, int32_t* width, int32_t* height);
/* width * height numbers, rows from the top, which lie in the image: "R", "G", "B", "depth.Z", ... */
KAIROS_API kairos_status kairos_image_channel(const kairos_image* image, const char* name, const float** values);
/* EXR or PNG, as the extension says; whole or not at all. */
KAIROS_API kairos_status kairos_write_image(const kairos_image* image, const char* path);

typedef struct kairos_write_options {
  uint32_t struct_size;
  int32_t half;     /* 16-bit colours in EXR */
  double exposure;  /* stops by which a PNG is brighter */
  const char* view; /* how a PNG shows colours: "standard" or "filmic"; NULL: as suits the picture */
} kairos_write_options;
KAIROS_API kairos_status kairos_write_image_as(const kairos_image* image, const char* path,
                                               const kairos_write_options* options);

#ifdef __cplusplus
}
#endif

#endif
