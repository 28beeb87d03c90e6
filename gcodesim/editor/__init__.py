"""What an editor asks about programs and cells: findings, meanings, completion; `server` speaks the protocol."""
