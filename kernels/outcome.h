// How a photon's path ends, and what a run of photons reports of it. Power shot + split = stored + absorbed + direct + lost
// + cut.
#ifndef VITRUM_OUTCOME_H
#define VITRUM_OUTCOME_H

#define OUTCOME_ALIVE 0u       // among tallies: shot
#define OUTCOME_STORED 1u      // on a diffuse surface after at least one specular one: the photon map holds it
#define OUTCOME_ABSORBED 2u    // by an opaque surface that does not scatter; among tallies with what media absorb
#define OUTCOME_DIRECT 3u      // met a diffuse surface first: shadow rays bring this light
#define OUTCOME_LOST 4u        // left the scene
#define OUTCOME_CUT 5u         // still alive at the depth limit, or of no power
#define OUTCOMES 6
#define TALLY_SPLIT 6u         // no end: photons that branched off, and the power that this gave less what it took
#define TALLIES 7

// A run: photons that one work-item follows. Power [W] is a float with what its sum lost in rounding beside it.
typedef struct {
  float power[TALLIES][3];     // by outcome; red, green, blue
  float power_rest[TALLIES][3];
  uint photons[TALLIES];       // by outcome
  uint rejected;               // would have been stored, were they all numbers
  uint surfaces;               // met by all of them
  float low[3], high[3];       // box around the stored [m]
} PhotonRunData;

#endif
