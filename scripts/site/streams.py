"""Output of cells that came in several chunks, as it was written."""

import functools


def joined(outputs):
    """One output for every stream, in the place of its first chunk; a chunk may end within a word.

    >>> chunks = [{"output_type": "stream", "name": "stdout", "text": text} for text in ("a resu", "lt\\n\\nb\\n")]
    >>> [output["text"] for output in joined(chunks)]
    ['a result\\n\\nb\\n']
    """
    streams, whole = {}, []
    for output in outputs:
        if output["output_type"] == "stream" and output["name"] in streams:
            streams[output["name"]]["text"] += output["text"]
            continue
        whole.append(output)
        if output["output_type"] == "stream":
            streams[output["name"]] = output
    return whole


def mend(render):
    """Joins chunks before myst_nb does (render: its module of that name), which ends every one with a line."""
    coalesce = render.coalesce_streams
    render.coalesce_streams = functools.wraps(coalesce)(lambda outputs: coalesce(joined(outputs)))
