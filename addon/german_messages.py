# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages in German: reports, errors, reasons, hints. Templates are English as in the source, with `{}` for values.

See `telling`. The German numbers the values, `{0}`, `{1}`; names in single quotes are values like others.
"""

MESSAGES = {
    # Waiting
    "{}: {}%   Esc: Stop": "{0}: {1}%   Esc: Abbrechen",
    "{}: {}%   Stopping": "{0}: {1}%   Wird abgebrochen",
}
