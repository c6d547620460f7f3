"""The largest constant feed as the aim: starts ranked by speed, refined by linear programmes."""
