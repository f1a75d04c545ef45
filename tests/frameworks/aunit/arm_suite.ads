with AUnit.Test_Suites;

package Arm_Suite is
   function Suite return AUnit.Test_Suites.Access_Test_Suite;
end Arm_Suite;
