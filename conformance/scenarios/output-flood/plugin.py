import rtf


class OutputFlood(rtf.TestCase):
    def run(self):
        for number in range(1_000_000):
            print("flood line", number)
