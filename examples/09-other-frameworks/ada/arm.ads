--  The arm of lesson 1, on the port that the fixture `arm` provides.

package Arm is

   --  Answers a line: `get elbow`. An answer other than `ok …` raises Refused.
   function Ask (Line : String) return String;

   Refused : exception;

end Arm;
