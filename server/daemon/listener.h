// SPDX-License-Identifier: Apache-2.0
/* listener.h: the sockets on which clients come. */
#ifndef TETRAD_DAEMON_LISTENER_H
#define TETRAD_DAEMON_LISTENER_H

#include "server/daemon/server.h"

/* Opens everything that the configuration names, or takes the inherited socket.
 * Errors: false, logged; what was opened stays open until listeners_close. */
bool listeners_open(server *server);

/* Accepts or stops accepting, by the number of connections. Called when that changes,
 * and now and then. */
void listeners_update(server *server);

/* Closes all and removes the Unix sockets' files. */
void listeners_close(server *server);

#endif
