"""Episodes that do nothing."""

import rtf


class EmptyEpisodes(rtf.EpisodeTest):
    """Only the overhead is measured."""

    def episode(self, episode: rtf.Episode) -> bool:
        """Passes without a step."""
        return episode.id > 0
