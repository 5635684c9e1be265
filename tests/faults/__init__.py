"""What happens when processes die, disks fill and files are tampered with: each fault is really made."""
