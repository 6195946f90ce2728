// All of the library's public headers.
#pragma once

#include "tetstream/client.h"
#include "tetstream/jobs.h"
#include "tetstream/labels.h"
#include "tetstream/mesh.h"
#include "tetstream/mesh_file.h"
#include "tetstream/mesher.h"
#include "tetstream/request.h"
#include "tetstream/sample.h"
#include "tetstream/scene.h"
#include "tetstream/session.h"
#include "tetstream/stable_session.h"
#include "tetstream/status.h"
#include "tetstream/stream.h"
#include "tetstream/transfer.h"
#include "tetstream/version.h"
#include "tetstream/volume.h"
