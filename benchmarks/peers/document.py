from benchmarks.peers.solve import Row


def line(row: Row) -> str:
    """A row of the run as it is printed."""
    own = row.ours
    text = f"{row.group:15s} {row.name:28s} {row.tolerance:<6g} {row.edges:6d} edges  "
    text += own.failed or f"{own.ms:9.3f} ms (dict {row.to_dict_ms:.3f}, json {row.to_json_ms:.3f}), {own.kept} segments"
    for peer in row.peers:
        ratio = row.ratio(peer.who)
        text += f" | {peer.who} " + (peer.failed or f"x{ratio:.1f} kept {peer.kept}")
    return text
