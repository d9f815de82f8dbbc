#pragma once

namespace rebake {

/// Whether the desktop wants dark windows: what its portal says (org.freedesktop.appearance), else GTK_THEME; dark
/// where nobody says anything. Asks another program, for at most half a second.
bool desktop_is_dark();

}  // namespace rebake
