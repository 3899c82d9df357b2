// A sequence of numbers as the host hands it to the sampler (sampler.h).
#ifndef VITRUM_SEQUENCE_H
#define VITRUM_SEQUENCE_H

#define PHOTON_DIMENSIONS 6

// One dimension of a sequence from some index on: the host adds up shift + first * alpha.
typedef struct {
  ulong start;
  ulong alpha;                 // 0: independent numbers instead, hashed from start and the index
} SequenceData;

#endif
