/* The four functions that core/ and a compiler without a C library need; memory.c has them. */
#ifndef SMARIG_STRING_H
#define SMARIG_STRING_H

#include <stddef.h>

void *memcpy(void *to, const void *from, size_t n);
void *memmove(void *to, const void *from, size_t n);
void *memset(void *to, int byte, size_t n);
int memcmp(const void *one, const void *other, size_t n);

#endif
