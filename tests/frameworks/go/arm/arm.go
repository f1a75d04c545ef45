// Package arm moves an arm.
package arm

// Reach returns the reach of an arm with this many joints, in metres.
func Reach(joints int) float64 {
	return 0.25 * float64(joints)
}
