"""What the workflow needs beside the library: jobs, what they depend on, and how they start."""
