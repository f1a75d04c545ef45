package arm

import (
	"errors"
	"fmt"
	"os"
	"testing"
	"time"
)

func TestMoves(t *testing.T) { // line: TestMoves
	if Reach(2) != 0.5 {
		t.Fatal("too short")
	}
}

func TestFails(t *testing.T) { // line: TestFails
	t.Log("before the failure")
	t.Errorf("expected %v, got %v\n  in the second line", 0.75, Reach(2)) // line: fails
}

func TestFailsInHelper(t *testing.T) {
	isClosed(t, true) // line: failsInHelper
}

func isClosed(t *testing.T, open bool) {
	t.Helper()
	if open {
		t.Fatal("the gripper is open")
	}
}

func TestFailsWithoutText(t *testing.T) {
	t.Fail()
}

func TestIsSkipped(t *testing.T) {
	t.Skip("no gripper (left, \"right\")") // line: isSkipped
}

func TestIsSkippedWithoutReason(t *testing.T) {
	t.SkipNow()
}

func TestPrints(t *testing.T) {
	fmt.Println("to stdout: <ä>")
	fmt.Fprintln(os.Stderr, "to stderr")
	fmt.Print("without end")
}

// The names look like those of a report.
func TestPrintsReport(t *testing.T) {
	fmt.Println("--- FAIL: TestMoves (0.00s)")
	fmt.Println(`{"Action":"fail","Test":"TestMoves"}`)
	t.Log("ok")
}

func TestSpeeds(t *testing.T) {
	for _, speed := range []string{"slow", "a/b", "x, y", "[z] \"q\"", "Überholt ✓", "slow"} {
		t.Run(speed, func(t *testing.T) {
			if speed == "x, y" {
				t.Errorf("%s is too fast", speed) // line: speeds
			}
		})
	}
}

func TestNested(t *testing.T) {
	t.Run("outer", func(t *testing.T) {
		t.Run("inner", func(t *testing.T) {
			t.Fatal(errors.New("it moved")) // line: inner
		})
		t.Run("skipped", func(t *testing.T) { t.Skip("not here") })
	})
}

func TestParallelFirst(t *testing.T) {
	t.Parallel()
	time.Sleep(10 * time.Millisecond)
	t.Error("first of two") // line: parallelFirst
}

func TestParallelSecond(t *testing.T) {
	t.Parallel()
	time.Sleep(10 * time.Millisecond)
	t.Log("second of two")
}

func TestParallelSubtests(t *testing.T) {
	for i := 0; i < 3; i++ {
		i := i
		t.Run(fmt.Sprint("arm", i), func(t *testing.T) {
			t.Parallel()
			if i == 1 {
				t.Error("arm 1 is late") // line: parallelSubtests
			}
		})
	}
}

func TestWithCleanup(t *testing.T) {
	t.Cleanup(func() { t.Error("the arm was not parked") }) // line: cleanup
}

func ExampleReach() {
	fmt.Println(Reach(4))
	// Output: 1
}

func ExampleReach_wrong() { // line: ExampleReach_wrong
	fmt.Println(Reach(3))
	// Output: 1
}

func FuzzReach(f *testing.F) {
	f.Add(1)
	f.Add(7)
	f.Fuzz(func(t *testing.T, joints int) {
		if joints == 7 {
			t.Fatal("seven joints") // line: fuzz
		}
	})
}

func BenchmarkReach(b *testing.B) {
	for i := 0; i < b.N; i++ {
		Reach(6)
	}
}
