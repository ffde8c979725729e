#include "tests/fuzz/seeds.h"

namespace meshfront::fuzz {

std::vector<Seed> textMeshSeeds() {
  return {
      {"ply", "valid-ascii",
       "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\n"
       "property double y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
       "property uchar blue\nproperty float nx\nproperty float ny\nproperty float nz\n"
       "property int confidence\nelement face 1\nproperty list uchar int vertex_indices\n"
       "end_header\n0 0 0 255 0 0 0 0 1 7\n1 0 0 0 255 0 0 0 1 7\n1 1 0 0 0 255 0 0 1 7\n"
       "0 1 0.5 9 9 9 0 0 1 7\n4 0 1 2 3\n"},
      {"ply", "valid-strips",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
       "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 1 2 3\n"},
      {"ply", "odd-index",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
       "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n0 1 nan\n3 0 1 -2147483648\n"},
      {"ply", "odd-counts",
       "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
       "property float z\nelement face 99999999999999\nproperty list uchar int vertex_indices\n"
       "end_header\n0 0 0\n"},
      {"ply", "odd-lists",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty list int float x\nproperty float y\n"
       "property float z\nelement edge 2\nproperty int a\nelement face 1\n"
       "property list int uint vertex_index\nproperty list uchar float texcoord\nend_header\n"
       "1 0 0 0\n1 1 0 0\n1 0 1 0\n1\n2\n3 0 1 2 6 0 0 0 0 0 0\n"},
      {"ply", "cut-header", "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty flo"},
      {"obj", "valid-corners",
       "# a square\nmtllib a.mtl\no square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvt 1 1\n"
       "vn 0 0 1\ng one\nusemtl red\ns 1\nf 1/1/1 2/2/1 \\\n 3/1/1\nf -4//1 -2//1 -1//1\nl 1 2\n"},
      {"obj", "valid-colours", "v 0 0 0 1 0 0\r\nv 1 0 0 0 1 0\r\nv 1 1 0 0 0 1\r\nf 1 2 3\r\n"},
      {"obj", "valid-wide-colours",
       "v 0 0 0 255 0 0 128\nv 1 0 0 0 9 0 1\nv 1 1 0 0 0 255 3\nf 1 2 3"},
      {"obj", "odd-indices",
       "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 0 1 2\nf 1 2 99999999999999999999\nf -9 1 2\n"},
      {"obj", "odd-numbers",
       "v 1e999 -0 .5\nv 1. 0x1 inf\nv + - e\nf 1 2 3\nf 1/ 2/ 3/\nf 1//// 2\n"},
      {"obj", "odd-lines", "v 1 2\n\\\n\\\nf\nv 1 2 3 4 5 6 7 8 9\nvn 1\np 1\ncurv 1\n\nf 1"},
      {"stl", "valid-ascii",
       "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
       "   vertex 0 1 1e-3\n  endloop\n endfacet\nendsolid a\n"},
      {"stl", "odd-words",
       "solid\nfacet normal 0 0 nan\nouter loop\nvertex 0 0 0\nvertex 1 0\nendloop\nendfacet\n"},
      {"stl", "cut", "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0"},
      {"off", "valid-plain", "OFF\n# a square\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"},
      {"off", "valid-all",
       "STCNOFF 3 1 3\n0 0 0 0 0 1 0.5 0.5 1 1 0 0\n1 0 0 0 0 1 0.5 0.5 1 1 0 0\n"
       "1 1 0 0 0 1 0.5 0.5 1 1 1 0\n3 0 1 2 1 0 0\n"},
      {"off", "odd-counts", "OFF\n4294967295 18446744073709551615 -1\n0 0 0\n"},
      {"off", "odd-prefix", "4OFF\n3 1 3\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n"},
      {"off", "odd-dimension", "nOFF\n2\n3 1 3\n0 0\n1 0\n0 1\n3 0 1 2\n"},
      {"off", "odd-index",
       "COFF\n3 1 3\n0 0 0 255 0 0 255\n1 0 0 0 0 0 0\n0 1 0 1 2 3 4\n3 0 1 3\n"},
  };
}

}  // namespace meshfront::fuzz
