"""What lies on and beside the lanes of a network: closed lanes with their cones, gores, curbs and ditches."""
