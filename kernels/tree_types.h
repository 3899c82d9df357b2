// The tree over triangles as it lies in device buffers. Host and device compile the same text; node 0 is the root.
//
// On the host include it through scene/tree.hpp, which puts it into namespace vitrum::kernel.
#ifndef VITRUM_TREE_TYPES_H
#define VITRUM_TREE_TYPES_H

#define TREE_WIDTH 8                // children of a node
#define TREE_LEAF_WIDTH 4           // triangles of a leaf
#define TREE_LEAF_BIT 0x80000000u   // set in a child reference: a leaf; the other bits are its index
#define TREE_EMPTY 0xffffffffu      // no child, and shape and primitive of no triangle

// Nodes on a path from the root, the root included. The builder keeps to it, so the traversal's stack has a proven
// size: on each level at most TREE_WIDTH - 1 siblings wait, on the last one all children do.
#define TREE_MAX_DEPTH 24
#define TREE_STACK_SIZE (TREE_MAX_DEPTH * (TREE_WIDTH - 1) + 1)

// Boxes are padded by TREE_PADDING times their greatest coordinate, and the ray's origin by TREE_PADDING times its own;
// tree.h says why this is enough for the traversal to find whatever the triangle test would hit.
#define TREE_PADDING 0x1p-18f

// Triangles that a ray can name (FROM_TRIANGLE in surface.h), of which a gather of four words each has indices below
// 2^31.
#define TREE_MAX_TRIANGLES 0x1fffffffu

// Coordinates up to here [m] neither overflow nor underflow in the triangle test.
#define TREE_MAX_COORDINATE 1e12f

// Boxes of the children, as planes[axis][0: low, 1: high][child]; no child: low = +INFINITY, high = -INFINITY.
typedef struct {
  float planes[3][2][TREE_WIDTH];
  unsigned int child[TREE_WIDTH];   // index of a node, or of a leaf with TREE_LEAF_BIT, or TREE_EMPTY
} TreeNode;

// Up to four triangles, as corners[a, b, c][axis][triangle]; no triangle: NaN, which nothing hits.
typedef struct {
  float corners[3][3][TREE_LEAF_WIDTH];
  unsigned int shape[TREE_LEAF_WIDTH];
  unsigned int primitive[TREE_LEAF_WIDTH];
} TreeLeaf;

// Equal sizes on both sides, or it does not compile.
typedef char tree_node_has_56_words[sizeof(TreeNode) == 56 * 4 ? 1 : -1];
typedef char tree_leaf_has_44_words[sizeof(TreeLeaf) == 44 * 4 ? 1 : -1];

#endif
