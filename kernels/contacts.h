// Surfaces in contact. A glass stands on a table in the table's very plane, a liquid fills a glass up to its wall's very
// triangles: within rounding they are at one place, and a ray that stepped from one to the next could jump over either.
// So all that lies within the rounding of a transparent surface belongs to one event: an opaque surface wins, and
// further transparent borders are crossed together with the first, as one border between the media before and after.
//
// Borders behind the first are packed into one uint, 9 bits each from the lowest on: medium (8 bits), entering (1 bit).
#ifndef VITRUM_CONTACTS_H
#define VITRUM_CONTACTS_H

#include "portability.h"

#define CONTACT_BITS 9u
#define MAX_CONTACTS 3u

FUNCTION uint packed_contact(uint medium, uint entering, uint place) {
  return (medium | entering << 8) << (CONTACT_BITS * place);
}

#endif
