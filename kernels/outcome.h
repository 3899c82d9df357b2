// How a photon's path ends. Power shot = stored + absorbed + direct + lost + cut.
#ifndef VITRUM_OUTCOME_H
#define VITRUM_OUTCOME_H

#define OUTCOME_ALIVE 0u
#define OUTCOME_STORED 1u      // on a diffuse surface after at least one specular one: the photon map holds it
#define OUTCOME_ABSORBED 2u    // by an opaque surface that does not scatter (absorption by media is counted beside it)
#define OUTCOME_DIRECT 3u      // met a diffuse surface first: shadow rays bring this light
#define OUTCOME_LOST 4u        // left the scene
#define OUTCOME_CUT 5u         // still alive at the depth limit, or of no power
#define OUTCOMES 6
#define OUTCOME_DONE 6u        // ended before, and counted

#endif
