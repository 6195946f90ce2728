// Which names of the shared library a program sees.
#pragma once

#if defined(__GNUC__)
#define TETSTREAM_API [[gnu::visibility("default")]]
#else
#define TETSTREAM_API
#endif
